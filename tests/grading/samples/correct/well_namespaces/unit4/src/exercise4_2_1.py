#!/usr/bin/env python3
import pathlib
import cv2 as cv
import rospy
import cv_bridge
import sensor_msgs.msg

def main():
    rospy.init_node("foto")
    rospy.Rate(2).sleep()
    mensaje = rospy.wait_for_message("image_raw", sensor_msgs.msg.Image)
    imagen = cv_bridge.CvBridge().imgmsg_to_cv2(mensaje, desired_encoding="passthrough")
    if mensaje.encoding == "rgb8":
        imagen = cv.cvtColor(imagen, cv.COLOR_RGB2BGR)
    fichero = pathlib.Path(rospy.get_param("/unit4/output", "foto.png"))
    codificada, datos = cv.imencode(fichero.suffix, imagen)
    assert codificada
    fichero.write_bytes(datos.tobytes())

main()
